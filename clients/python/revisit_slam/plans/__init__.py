"""Floor plans as prior anchors: the signs that a building has, before any robot has seen one."""
