"""Fixtures of all tests of pages."""

from tests.verification.report.browser import chromium, idle_pages, visit

__all__ = ["chromium", "idle_pages", "visit"]
