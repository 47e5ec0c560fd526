function found = laws()
  % Hyperelastic laws that there are: name, title, parameters in their order ('c1 [Pa], c2 [Pa]').
  found = dea_mex('laws');
end
