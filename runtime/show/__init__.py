"""To look at a trace: a page for the browser, pictures, a film."""
