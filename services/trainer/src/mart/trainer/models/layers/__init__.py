"""Networks with a leading model axis: many models of one shape, trained in one step."""
