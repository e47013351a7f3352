"""The web service: people join, take seats, watch and drive; browsers and phones speak to nothing else over HTTP."""
