"""Who may come in: names of the site, the join code, sessions, codes that pair phones, and how often one may try."""
