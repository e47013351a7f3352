"""The web service as one process: its settings, its certificate, the ASGI application and the server that runs it."""
