"""What several cases share: walls, exact paths, hardening laws, assemblies."""
