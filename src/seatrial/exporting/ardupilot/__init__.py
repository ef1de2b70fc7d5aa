"""Parameters of ArduPilot for boats: its controller, tuned and simulated on the identified craft."""
