"""Running a study: sessions, trials one after the other, the devices that present them."""
