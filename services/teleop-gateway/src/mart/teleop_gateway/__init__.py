"""Turn phones and browsers into operators, and states into the pictures they see: WebRTC in front, Zenoh behind."""
