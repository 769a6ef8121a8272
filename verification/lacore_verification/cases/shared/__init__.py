"""Shared parts of several cases: walls, exact paths, hardening laws, assemblies."""
