loadrt madebytcl
