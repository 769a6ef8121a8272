"""The catalogue: cases of lacore and of others, checked before anything of them runs."""
