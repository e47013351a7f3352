"""What people ask about recorded episodes, answered over the bus: `mart catalogue`."""
