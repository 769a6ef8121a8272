"""Pictures of answers to questions of engineers."""
