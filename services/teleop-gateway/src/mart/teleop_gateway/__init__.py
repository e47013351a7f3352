"""WebRTC in front, Zenoh behind: phones and browsers become operators, states become the pictures they see."""
