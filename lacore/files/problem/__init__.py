"""Problems as TOML: read without running anything, written, and told as Python."""
