"""Libraries of behaviours, one file each; `behaviours/catalogue.py` names them."""
