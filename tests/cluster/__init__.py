"""Whether anybody notices when one of several servers behind a proxy, or the proxy, goes. Run by deploy/test-cluster."""
