"""Fixtures of all tests of pages."""

from tests.verification.report.browser import chromium, visit

__all__ = ["chromium", "visit"]
