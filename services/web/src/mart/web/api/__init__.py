"""The HTTP API (docs/protocol.md, section 2): each route turns a request into one call and its result into JSON."""
