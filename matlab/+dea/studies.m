function found = studies()
  % Studies that there are, and the keys that they need.
  found = dea_mex('studies');
end
