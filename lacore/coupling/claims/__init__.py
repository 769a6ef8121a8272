"""What is claimed of a program without a load factor, proven: locked, unsafe, carried, free."""
