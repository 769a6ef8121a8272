"""Verification cases, one file each; `verification.catalogue` finds them."""
