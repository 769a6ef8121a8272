"""Large deformation: a limit problem a step (T29-T32)."""
