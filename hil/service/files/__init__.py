"""Files that people give: uploads, the catalogues of what can be used, plans."""
