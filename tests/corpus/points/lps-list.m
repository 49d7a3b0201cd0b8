% coordinates in LPS
pts = [42 20 50; % M1
       -38 -14 -4];
