"""What the web service asks of other services: each request becomes a query on the bus."""
