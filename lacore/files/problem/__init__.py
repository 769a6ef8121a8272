"""Problems as TOML: read without running code, written, and converted to Python."""
