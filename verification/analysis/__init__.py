"""What results say: pandas in, pandas out; each function documents the columns it returns.

All of it takes the frame of `load_results`, one row a finished run; only `summary`, one answer a
variant, takes outcomes.
"""
