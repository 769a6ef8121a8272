"""Verification cases, one file each; `lacore_verification.catalogue.catalogue` finds them."""
