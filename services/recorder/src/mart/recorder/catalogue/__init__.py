"""Answer what people ask about recorded episodes over the bus: `mart catalogue`."""
