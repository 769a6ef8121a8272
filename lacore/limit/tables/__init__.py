"""What a state shows as tables: contact points, forces of supports."""
