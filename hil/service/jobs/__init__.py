"""Identifications, diagnoses, designs and campaigns that people start, and what they leave."""
