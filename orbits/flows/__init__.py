"""What happens between two events: one protocol, fulfilled by closed forms (`native`) and by pages (`page`)."""
