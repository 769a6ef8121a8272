"""What a problem file may say: one class an entry, with units and where each lands in lacore."""
