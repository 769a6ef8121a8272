"""Catalogue of cases of lacore and of users, checked before any of them runs."""
