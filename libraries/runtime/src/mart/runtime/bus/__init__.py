"""The seam between services and Zenoh: `Bus`, the real one, and an in-memory twin for unit tests."""

from mart.runtime.bus.base import Bus, Closable, Handler, Publisher, Request, RequestHandler, Sample

__all__ = ["Bus", "Closable", "Handler", "Publisher", "Request", "RequestHandler", "Sample"]
