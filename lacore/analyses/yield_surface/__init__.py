"""Which combinations of loads are carried: convex bodies between points and planes (T82)."""
