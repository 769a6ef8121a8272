"""Verification cases, one file each; `verification.catalogue.catalogue` finds them."""
