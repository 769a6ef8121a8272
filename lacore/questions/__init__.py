"""Questions of engineers: which loads govern, what is just enough, what matters, what is safe."""
