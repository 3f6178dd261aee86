"""What was found, told: verdict, names, confidence, places, tests that would separate."""
