% from MATLAB, LPS
P = [42 20 50; 30 20 50];
