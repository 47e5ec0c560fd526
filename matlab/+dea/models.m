function found = models()
  % Models that there are: name, title, abilities (of discs), available,
  % layout_abilities (of devices made of plies).
  found = dea_mex('models');
end
