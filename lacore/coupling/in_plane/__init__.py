"""What the certified loop tries of plane blocks alone."""
