"""Why a task was not solved, in words: from what a search came near to, and what a domain knows."""
