"""The browser lab: a server for one computer, and static pages without a build step."""
