function found = findings()
  % What was found by the last call that reads, sets, checks or runs a design.
  found = dea_mex('findings');
end
