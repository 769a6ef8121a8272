"""The contract with backends, the registry of those installed, and the processes they work in."""
