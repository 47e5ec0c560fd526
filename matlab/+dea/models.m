function found = models()
  % Models that there are: name, title, abilities, available.
  found = dea_mex('models');
end
