class AcquisitionType:
    FINITE = "finite"
