"""What editors need of the language: a TextMate grammar, and an extension for VS Code."""
