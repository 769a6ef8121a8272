"""What the user says, checked."""
