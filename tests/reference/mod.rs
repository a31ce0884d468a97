mod horizon;
