"""What was found, stated: verdict, names, confidence, places, tests that would separate."""
