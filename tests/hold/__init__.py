"""Whether anything stops a server: traffic, faults, a recorded history, and a program that checks it. Run by deploy/test-hold."""
