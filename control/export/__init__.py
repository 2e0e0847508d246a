"""What contains controllers: the browser page and the controller's FMU."""
